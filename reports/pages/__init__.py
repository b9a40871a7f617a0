"""Pages: a run, a study, a comparison, in HTML."""
