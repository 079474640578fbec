"""Effective friction, loads and the slip of running away over a grid, to look at by moving sliders."""

from rollslip.catalogue.campaign import Campaign
from rollslip.hookspecs import hookimpl


@hookimpl
def campaigns() -> list[Campaign]:
    """Offer the campaign."""
    return [
        Campaign(
            name="explore",
            summary="Write a page in which load, speed, temperature, clearance and models of SCENE move by sliders.",
            command="rollslip_campaigns.explorer.command:explore",
            function="rollslip_campaigns.explorer.explorer:explore",
        ),
    ]
