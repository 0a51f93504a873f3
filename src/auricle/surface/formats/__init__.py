"""Surface files, one format a module: what its header announces, how it is parsed and written."""
