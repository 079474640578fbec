"""Hold models against what was measured: data sets, predictions of any program, and which law is the better one."""
