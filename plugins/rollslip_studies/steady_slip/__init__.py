"""Study steady-slip: the cage slips at which a bearing runs on."""
