"""The wire model in other people's finite-element codes, built from `coilspring` alone."""
