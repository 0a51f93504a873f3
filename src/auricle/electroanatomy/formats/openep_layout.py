"""Where OpenEP's structure ``userdata`` keeps what auricle reads and writes of it."""

ROOT = "userdata"
POSITIONS = "electric.egmX"
PROJECTED = "electric.egmSurfX"
BIPOLAR_SIGNALS = "electric.egm"
UNIPOLAR_SIGNALS = "electric.egmUni"
REFERENCE_SIGNALS = "electric.egmRef"
SAMPLING_RATE = "electric.sampleFrequency"
WINDOW = "electric.annotations.woi"
REFERENCE_ANNOTATION = "electric.annotations.referenceAnnot"
MAP_ANNOTATION = "electric.annotations.mapAnnot"
BIPOLAR_VOLTAGE = "electric.voltages.bipolar"
UNIPOLAR_VOLTAGE = "electric.voltages.unipolar"
IMPEDANCE = "electric.impedances.value"
FORCE = "electric.force.force"
INCLUDED = "electric.include"
VERTICES = "surface.triRep.X"
FACES = "surface.triRep.Triangulation"
ACTIVATION_BIPOLAR = "surface.act_bip"
UNIPOLAR_IMPEDANCE_FORCE = "surface.uni_imp_frc"

NUMBERS = (
    POSITIONS,
    PROJECTED,
    BIPOLAR_SIGNALS,
    UNIPOLAR_SIGNALS,
    REFERENCE_SIGNALS,
    SAMPLING_RATE,
    WINDOW,
    REFERENCE_ANNOTATION,
    MAP_ANNOTATION,
    BIPOLAR_VOLTAGE,
    UNIPOLAR_VOLTAGE,
    IMPEDANCE,
    FORCE,
    INCLUDED,
    VERTICES,
    FACES,
    ACTIVATION_BIPOLAR,
    UNIPOLAR_IMPEDANCE_FORCE,
)
"""Every array of numbers, by dotted path."""
ALTERNATIVES = {
    VERTICES: ("surface.triRep.Points",),
    FACES: ("surface.triRep.ConnectivityList",),
}
"""Where else they are found: MATLAB's ``triangulation`` saved as a structure."""
SURFACE_COLUMNS = {
    ACTIVATION_BIPOLAR: ("local_activation_time", "bipolar_voltage"),
    UNIPOLAR_IMPEDANCE_FORCE: ("unipolar_voltage", "impedance", "force"),
}
"""Columns of the arrays at vertices."""
POINT_COLUMNS = {
    "bipolar_voltage": BIPOLAR_VOLTAGE,
    "unipolar_voltage": UNIPOLAR_VOLTAGE,
    "impedance": IMPEDANCE,
    "force": FORCE,
}
"""Columns of mapping points; activation times are differences of annotations."""
