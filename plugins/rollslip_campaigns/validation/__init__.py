"""Hold models against what was measured: data sets, predictions of any program, and which law is the better one."""

from rollslip.catalogue.campaign import Campaign
from rollslip.hookspecs import hookimpl


@hookimpl
def campaigns() -> list[Campaign]:
    """Offer the campaigns."""
    return [
        Campaign(
            name="validate",
            summary="Hold models against data sets, by name or folder; by default all data sets that are installed.",
            command="rollslip_campaigns.validation.command:validate",
        ),
        Campaign(
            name="rank",
            summary="Rank laws by their errors on conditions of DATA that they were not fitted to.",
            command="rollslip_campaigns.validation.command:rank",
        ),
    ]
