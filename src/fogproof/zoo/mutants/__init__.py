"""Systematic errors planted in every case of the catalogue, with the least number of samples at which any test could tell."""
