"""Fit parameters of a law to measured friction."""

from rollslip.catalogue.campaign import Campaign
from rollslip.hookspecs import hookimpl


@hookimpl
def campaigns() -> list[Campaign]:
    """Offer the campaign."""
    return [
        Campaign(
            name="fit",
            summary="Fit parameters of oil and traction model to DATA of a traction rig, "
            "and write results, plots and an oil.",
            command="rollslip_campaigns.fit.command:fit",
            function="rollslip_campaigns.fit.fit:fit",
        ),
    ]
