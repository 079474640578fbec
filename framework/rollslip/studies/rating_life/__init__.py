"""Models of the rating life of a bearing."""
