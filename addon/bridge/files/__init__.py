"""Files that the add-on reads and writes, each staged beside its target and renamed into place."""
