"""Catalogue of the models and data that packages offer, and construction of a model by its name."""
