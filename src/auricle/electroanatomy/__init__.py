"""Electroanatomical maps: studies of mapping systems, their points, electrograms and features."""
