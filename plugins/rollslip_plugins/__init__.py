"""The built-in models; they use the same entry points and interfaces as models of third parties."""
