"""Features of electrograms, one family a module, each with its definition and source."""
