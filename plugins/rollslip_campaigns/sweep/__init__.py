"""Run one study at many points."""

from rollslip.catalogue.campaign import Campaign
from rollslip.hookspecs import hookimpl


@hookimpl
def campaigns() -> list[Campaign]:
    """Offer the campaign."""
    return [
        Campaign(
            name="sweep",
            summary="Compute many points of a study: a grid, samples, several models; go on after whatever happens.",
            command="rollslip_campaigns.sweep.command:sweep",
            function="rollslip_campaigns.sweep.folder:sweep",
        ),
    ]
