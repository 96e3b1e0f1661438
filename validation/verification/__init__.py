"""The wire model and the laws against exact solutions and each other, each as a page."""
