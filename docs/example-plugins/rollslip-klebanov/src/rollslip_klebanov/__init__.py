"""The paper that rollslip follows, as its authors may have computed it; found through an entry point."""
