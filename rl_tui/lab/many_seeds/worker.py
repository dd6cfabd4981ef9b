"""What works out a study in the process of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from rl_tui.lab.workers.answering import answer, let_others_go_first

if TYPE_CHECKING:
    from rl_tui.lab.many_seeds.figures import SeedStudy
    from rl_tui.lab.many_seeds.request import StudyRequest

_LONGEST_REASON: Final = 200


def main() -> None:
    """Work out what stdin asks for, and end when that is done or stdin ends, be it in the middle."""
    answer(_work)


def _work(request: StudyRequest, tell: Callable[[dict[str, Any]], None]) -> None:
    from rl_tui.common.errors import UserError
    from rl_tui.common.findings import one_line
    from rl_tui.lab.many_seeds.figures import StudyState
    from rl_tui.lab.many_seeds.study_json import as_json
    from rl_tui.worlds.gym.modules import ALLOWED

    ALLOWED.update(request.modules)
    study = request.nothing_yet
    try:
        for study in _reports(request):
            tell(as_json(study))
    except Exception as error:  # whatever a world may do to this process
        name = "" if isinstance(error, UserError) else f"{type(error).__name__}: "
        why = one_line(f"{name}{error}", _LONGEST_REASON)
        tell(as_json(replace(study, state=StudyState.FAILED, message=why)))


def _reports(request: StudyRequest) -> Iterator[SeedStudy]:
    """Yield what is known, at the lowest priority as soon as there is machine code."""
    from rl_tui.lab.many_seeds.study import Study

    study = Study(request)
    if study.has_machine_code and not request.is_awaited:
        let_others_go_first()
    study.get_machine_code()
    if not request.is_awaited:
        let_others_go_first()
    yield from study.reports()
