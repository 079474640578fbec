"""Compare models on one scene."""

from rollslip.catalogue.campaign import Campaign
from rollslip.hookspecs import hookimpl


@hookimpl
def campaigns() -> list[Campaign]:
    """Offer the campaign."""
    return [
        Campaign(
            name="compare",
            summary="Run every combination of models on SCENE; compare friction, critical slip and cost.",
            command="rollslip_campaigns.comparison.command:compare",
            function="rollslip_campaigns.comparison.comparison:compare",
        ),
    ]
