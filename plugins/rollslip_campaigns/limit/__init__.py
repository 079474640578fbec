"""Where a result passes a limit as one quantity of the scene moves: the search, told and drawn."""
