"""The same bearing moving: rates, integration in time, balance of torques and continuation."""
