"""What all studies share: scenes, metrics, timing, stored runs, documents, plots, files of a run."""
