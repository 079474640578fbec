"""Models of how heat leaves a bearing."""
