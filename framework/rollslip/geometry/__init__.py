"""Geometry, materials and seats of a bearing as frozen values: keys of a scene, and values of named data sets."""
