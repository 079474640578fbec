"""Hold the error of numerical and modelling choices against their cost."""

from rollslip.catalogue.campaign import Campaign
from rollslip.hookspecs import hookimpl


@hookimpl
def campaigns() -> list[Campaign]:
    """Offer the campaign."""
    return [
        Campaign(
            name="pareto",
            summary="Hold error against cost for the studies of SCENE: a family of choices, "
            "and the front that none of them passes.",
            command="rollslip_campaigns.pareto.command:pareto",
            function="rollslip_campaigns.pareto.pareto:pareto",
        ),
    ]
