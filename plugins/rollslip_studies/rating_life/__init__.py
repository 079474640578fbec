"""Study rating-life: rating life of the bearing, by models of kind life, and where the damage arises."""
