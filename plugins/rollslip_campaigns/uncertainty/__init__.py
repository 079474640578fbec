"""What scattered input does to the slip that is allowed."""

from rollslip.catalogue.campaign import Campaign
from rollslip.hookspecs import hookimpl


@hookimpl
def campaigns() -> list[Campaign]:
    """Offer the campaign."""
    return [
        Campaign(
            name="uncertainty",
            summary="Tell the reserve of drag, the steady slip and the least load of SCENE where its data scatter.",
            command="rollslip_campaigns.uncertainty.command:uncertainty",
            function="rollslip_campaigns.uncertainty.margin:uncertainty",
        ),
    ]
