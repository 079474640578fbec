"""Study friction-curve: friction of one contact over its slide-roll ratio."""
