"""The view that segments, in a browser."""

import json
import threading
from dataclasses import replace

import numpy as np
import pydicom
import pytest

from auricle.imaging.dicom_writing import write_dicom_series
from auricle.imaging.segmentation import segment
from auricle.imaging.verdict import REMEDIES
from auricle.progress import silent
from auricle.simulation.phantom import PhantomOptions, phantom
from auricle.study.result import Source
from auricle.study.segmented import SegmentationConfig
from auricle.viewer.opening import Detail, open_path
from auricle.viewer.volume_session import VolumeSession, drawn_lattice

SKETCH_MM, PREVIEW_MM = 3.0, 2.0
NAME = '<img src=x onerror="alert(1)">.nrrd'


@pytest.fixture(scope="module")
def patient():
    return phantom(PhantomOptions(preset="tiny", seed=1))


@pytest.fixture
def session(patient):
    volume = replace(patient.volume, remarks=("<b>bold</b> remark",))
    source = Source(NAME, 1, "0" * 64)
    spacings = {"sketch_mm": SKETCH_MM, "preview_mm": PREVIEW_MM}
    return VolumeSession(volume, source, drawn_lattice(volume), **spacings)


@pytest.fixture
def page(serve, browsing, session):
    shown = browsing.open(serve(session, Detail(400, 30), name=NAME).address)
    previewed(shown)
    return shown


def previewed(page):
    """Waits until the preview is that of the choices as they are."""
    page.wait_for_selector(f"[data-fact=kind]:text-is('preview at {PREVIEW_MM:g} mm')")


def fact(page, name):
    return page.locator(f"[data-fact={name}]").inner_text()


def volume_ml(page):
    return float(fact(page, "volume").split()[0])


def on_slice(page, plane, place):
    """Where a place in mm lies on the screen."""
    canvas = page.locator(f"canvas[data-plane={plane}]")
    across, along, down = {"axial": (0, 1, 1), "coronal": (0, 2, -1), "sagittal": (1, 2, -1)}[plane]
    middle = [float(part) for part in canvas.get_attribute("data-middle").split(",")]
    scale = float(canvas.get_attribute("data-scale"))
    box = canvas.bounding_box()
    x = box["x"] + box["width"] / 2 + (place[across] - middle[0]) / scale
    y = box["y"] + box["height"] / 2 + down * (place[along] - middle[1]) / scale
    return x, y


def crosshair(page):
    text = page.locator("canvas[data-plane=axial]").get_attribute("data-cross")
    return np.array([float(part) for part in text.split(",")])


def pixels(page, plane):
    return page.locator(f"canvas[data-plane={plane}]").evaluate(
        "(canvas) => { const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width,"
        " canvas.height); let sum = 0; for (let i = 0; i < data.length; i += 1)"
        " sum = (sum * 31 + data[i]) % 1000000007; return sum; }"
    )


def expected(patient, **choices):
    config = SegmentationConfig(**choices)
    return segment(patient.volume, replace(config.options, step=PREVIEW_MM)).volume_ml


def test_a_threshold_moved_changes_slices_and_volume_and_undo_restores_both(page, patient):
    before, picture = volume_ml(page), pixels(page, "axial")
    assert before == pytest.approx(expected(patient), abs=0.06)
    assert np.linalg.norm(crosshair(page) - patient.truth.seed) < 15.0
    slider = page.locator("[data-threshold=lower_hu]")
    lower = int(slider.input_value()) + 40
    slider.fill(str(lower))
    previewed(page)
    assert volume_ml(page) == pytest.approx(expected(patient, lower_hu=lower), abs=0.06)
    assert volume_ml(page) != before
    assert pixels(page, "axial") != picture
    page.locator("canvas[data-plane=axial]").focus()
    page.keyboard.press("Control+z")
    previewed(page)
    assert volume_ml(page) == before
    page.get_by_role("button", name="Redo").click()
    previewed(page)
    assert volume_ml(page) != before


def test_seed_region_and_cutters_are_drawn_on_the_slices(page, patient):
    seed = patient.truth.seed
    page.get_by_role("button", name="Seed", exact=True).click()
    page.mouse.click(*on_slice(page, "axial", seed))
    shown = fact(page, "seed").replace("−", "-").removesuffix(" mm")
    placed = np.array([float(part) for part in shown.split(",")])
    np.testing.assert_allclose(placed[:2], seed[:2], atol=1.5)
    previewed(page)

    page.get_by_role("button", name="Outline").click()
    around = crosshair(page)
    corners = [(-45, -40), (45, -40), (45, 40), (-45, 40), (-45, -40)]
    for across, along in corners:
        page.mouse.click(*on_slice(page, "axial", around + np.array([across, along, 0.0])))
    assert fact(page, "region") == "outline of 4 corners"
    previewed(page)

    page.get_by_role("button", name="Wall cut").click()
    page.mouse.move(*on_slice(page, "coronal", around + np.array([20.0, 0.0, -15.0])))
    page.mouse.down()
    page.mouse.move(*on_slice(page, "coronal", around + np.array([20.0, 0.0, 15.0])), steps=3)
    page.mouse.up()
    page.get_by_role("button", name="Ball cut").click()
    page.mouse.click(*on_slice(page, "sagittal", around + np.array([0.0, 0.0, 18.0])))
    previewed(page)
    assert page.locator(".cuts li").count() == 2
    command = page.locator(".command").inner_text()
    assert command.count("--cut=") == 2
    assert "--roi=" in command
    choices = choices_of(command)
    assert volume_ml(page) == pytest.approx(expected(patient, **choices), abs=0.06)


def choices_of(command):
    """The parameters a command line would give."""
    options = dict.fromkeys(["seed", "roi"])
    cuts = []
    for word in command.split():
        name, _, value = word.removeprefix("--").partition("=")
        if name == "cut":
            cuts.append(tuple(map(float, value.split(","))))
        elif name in options:
            options[name] = tuple(tuple(map(float, each.split(","))) for each in value.split(":"))
    return {"seed_mm": options["seed"][0], "region_mm": options["roi"], "cuts_mm": tuple(cuts)}


def test_the_keyboard_moves_the_cross_and_a_seed_outside_the_blood_is_refused_by_name(page):
    canvas = page.locator("canvas[data-plane=axial]")
    canvas.focus()
    before = crosshair(page)
    for key in ["ArrowRight", "ArrowDown", "Shift+ArrowLeft"]:
        page.keyboard.press(key)
    redrawn(canvas)
    np.testing.assert_allclose(crosshair(page) - before, [-9.0, 1.0, 0.0], atol=1e-9)
    page.keyboard.press("s")
    page.keyboard.press("Enter")
    assert "found" not in fact(page, "seed")
    page.keyboard.press("Control+z")
    assert "found" in fact(page, "seed")
    previewed(page)

    page.get_by_role("button", name="Whole").click()
    redrawn(canvas)
    canvas.click(position={"x": canvas.bounding_box()["width"] / 2, "y": 12})
    page.wait_for_selector(".verdict.refused")
    assert page.locator(".reasons [data-code]").get_attribute("data-code") in REMEDIES
    assert fact(page, "volume") == "– ml"
    assert page.get_by_role("button", name="Accept").is_disabled()


def redrawn(canvas):
    """Waits until the picture of now is on the screen."""
    canvas.evaluate(
        "() => new Promise((done) => setTimeout(() => requestAnimationFrame(done), 50))"
    )


def test_a_result_is_accepted_once_looked_at_and_opens_as_a_surface(page, session, browsing):
    assert page.locator("img").count() == 0
    assert fact(page, "name") == NAME
    assert "<b>bold</b> remark" in page.locator(".facts").first.inner_text()
    assert browsing.violations() == []
    accept = page.get_by_role("button", name="Accept")
    if page.locator(".verdict.check").count():
        assert accept.is_disabled()
        page.get_by_label("I have looked at each of them").check()
    assert volume_ml(page) == pytest.approx(
        session.trial(SegmentationConfig()).found.volume_ml, abs=0.06
    )
    with page.expect_download() as saved:
        page.get_by_role("button", name="Picture (PNG)").click()
    assert saved.value.suggested_filename == "slices.png"
    assert saved.value.path().read_bytes().startswith(b"\x89PNG")
    accept.click()
    page.wait_for_selector("nav button[aria-current=page]:text-is('Explore')")
    page.locator("nav button:text-is('Segment')").click()
    with page.expect_download() as saved:
        page.get_by_role("button", name="result.json").click()
    document = json.loads(saved.value.path().read_text(encoding="utf-8"))
    assert document["mask_volume_ml"] == pytest.approx(session.accepted.mask.volume_ml)
    previewed_mask = session.trial(SegmentationConfig()).found.mask
    assert session.accepted.segmentation.mask is previewed_mask


def test_another_choice_gives_the_preview_up_and_only_previews_are_accepted(
    serve, browsing, patient
):
    source = Source("scan.nrrd", 1, "0" * 64)
    shown = drawn_lattice(patient.volume)
    session = VolumeSession(patient.volume, source, shown, sketch_mm=SKETCH_MM)
    held = threading.Event()
    trial = session.trial

    def patient_trial(config, *, sketch=False, progress=silent):
        """The first preview comes no further until something else is chosen."""
        if sketch or config.lower_hu is not None:
            return trial(config, sketch=sketch, progress=progress)
        while not held.wait(0.05):
            progress("chambers", 3, 6)
        return trial(config, progress=progress)

    session.trial = patient_trial
    server = serve(session)
    page = browsing.open(server.address)
    page.wait_for_selector(
        f"[data-fact=kind]:text-is('sketch at {SKETCH_MM:g} mm, preview: chambers …')"
    )
    assert page.get_by_role("button", name="Accept").is_disabled()
    page.locator("[data-threshold=lower_hu]").fill("260")
    page.wait_for_selector("[data-fact=kind]:text-is('preview at 1 mm')")
    assert not held.is_set()
    assert session.accepted is None
    assert server.workspace.busy.acquire(timeout=60)
    server.workspace.busy.release()


def test_nobody_s_name_is_on_the_page_of_a_dicom_series(serve, browsing, patient, tmp_path):
    folder = tmp_path / "CANARYNAME^ANNA 19530412"
    write_dicom_series(patient.volume, folder)
    for place in folder.iterdir():
        header = pydicom.dcmread(place)
        header.PatientName, header.PatientID = "CANARYNAME^ANNA", "CANARYID"
        header.PatientBirthDate, header.InstitutionName = "19530412", "CANARYHOSPITAL"
        header.SeriesDescription = "CANARYNAME heart"
        header.save_as(place)
    server = serve()
    open_path(server.workspace, folder)
    answers = []
    browsing.page.on("response", lambda answer: answers.append(answer))
    page = browsing.open(server.address)
    page.wait_for_selector("[data-fact=kind]:text-is('preview at 1 mm')")
    streamed = [each for each in answers if "ndjson" in each.headers.get("content-type", "")]
    whole = [each for each in answers if is_text(each) and each not in streamed]
    told = page.content() + page.title() + "".join(each.text() for each in whole)
    assert [each.url.rpartition("/")[2] for each in streamed] == ["preview"]
    told += page.evaluate(ASK_AGAIN)
    assert '"result"' in told
    assert "DICOM series" in told
    for canary in ("CANARY", "19530412", "ANNA"):
        assert canary not in told


ASK_AGAIN = """async () => {
  const headers = {
    Authorization: `Bearer ${sessionStorage.getItem("auricle-secret")}`,
    "Content-Type": "application/json",
  };
  const answer = await fetch("/api/segment/preview", { method: "POST", headers, body: "{}" });
  return answer.text();
}"""
"""The stream of a preview, which the browser does not keep."""


def is_text(answer):
    return "json" in answer.headers.get("content-type", "") or "event" in answer.headers.get(
        "content-type", ""
    )
