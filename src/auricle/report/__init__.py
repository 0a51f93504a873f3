"""Figures, tables and the page one can send: the only room that draws."""
