"""Results: datasets and their files, answers, figures, tables and reports."""
