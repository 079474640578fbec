"""Where a result passes a limit as one quantity of the scene moves: the search, told and drawn."""

from rollslip.catalogue.campaign import Campaign
from rollslip.hookspecs import hookimpl


@hookimpl
def campaigns() -> list[Campaign]:
    """Offer the campaign."""
    return [
        Campaign(
            name="limit",
            summary="Search where a result of SCENE passes a limit while one quantity moves.",
            command="rollslip_campaigns.limit.command:limit",
            function="rollslip_campaigns.limit.limit:limit",
        ),
    ]
