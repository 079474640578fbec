"""The levels of detail of a bearing in motion, and the friction of its raceways there."""
