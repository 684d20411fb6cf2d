"""The second operator: images in random order, outlined without seeing what the first drew."""

from typing import Any, Final

from fingerpad.study.corrections.apply import contact_correction
from fingerpad.study.measuring.operators import blind_order
from fingerpad.web import answers
from fingerpad.web.endpoints import Endpoint
from fingerpad.web.last_results import last_results
from fingerpad.web.state import review_record
from fingerpad.web.workspace import Workspace


def second_operator(workspace: Workspace, _: Any, __: Any) -> dict[str, Any]:
    """Return the images in random order with the second operator's review, and the last run's agreement."""
    opened = workspace.study
    first, second = opened.corrections.active_corrections(), opened.second_operator.active_corrections()
    named = {one.name: one for one in opened.with_incomplete().observations if one.file and one.scale}
    looked = [
        name
        for name in named
        if (change := contact_correction(first.get(name))).accepted or (change.edits and not change.rejected)
    ]
    found = last_results(opened)
    return {
        "first_operators": sorted({first[name].who for name in looked}),
        "images": [{"item": name, **review_record(second.get(name))} for name in blind_order(looked)],
        "unseen": len(named) - len(looked),
        "agreement": found.summary.get("second_operator", []) if found else [],
    }


ENDPOINTS: Final = (
    Endpoint(
        method="GET",
        path="/api/study/second-operator",
        answer=second_operator,
        model=answers.SecondOperator,
        summary="Images for a second operator in random order, and the agreement with the first",
    ),
)
