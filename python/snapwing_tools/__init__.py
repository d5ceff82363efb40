"""Recording of runs and their reports: what a run stores, what is worked out of it, and how it is shown."""
