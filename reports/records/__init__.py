"""Records of runs and studies, read and written."""
