"""auricle: how many points a cardiac map needs, where, and how sure one can be."""

__version__ = "0.1.0"
