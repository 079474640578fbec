"""Operation that changes in time: what is written of it, and the motion of a bearing along it."""
