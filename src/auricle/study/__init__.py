"""One case from file to result: configuration, procedure, provenance, storage."""
