"""Compare models on one scene."""
