"""Exports of mapping systems, one format a module: how they are read, bounded and written."""
