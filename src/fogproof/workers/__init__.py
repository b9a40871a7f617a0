"""Where parts of long work are done: threads, processes, or a cluster."""
