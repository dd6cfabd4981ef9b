"""A picture of a sweep's store equals a picture of its JSON."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rl_tui.common.errors import UserError
from rl_tui.runs.library import find
from rl_tui.studies.pictures.reading import read_results, results_of
from rl_tui.studies.pictures.tables import SweepTable
from rl_tui.studies.sweeps.cells.variation import read_variation
from rl_tui.studies.sweeps.document import best_documents, json_pieces
from rl_tui.studies.sweeps.plan import SweepPlan
from rl_tui.studies.sweeps.ranking import standings_of
from rl_tui.studies.sweeps.store import Store
from rl_tui.studies.sweeps.sweep import run_sweep


def filled(path: Path) -> object:
    variations = tuple(map(read_variation, ("alpha=0.1,0.5", "epsilon=0.1,0.3")))
    plan = SweepPlan(find("student"), variations, episodes=20, runs=3)
    with Store.to_write(path) as store:
        run_sweep(plan, store)
        standings = standings_of(plan, store)
        bests = best_documents(standings, plan, store, again=False)
        return json.loads("".join(json_pieces(plan, store, standings, bests)))


def test_a_store_holds_what_its_document_says(tmp_path: Path) -> None:
    document = filled(tmp_path / "a.sqlite")
    read = read_results(tmp_path / "a.sqlite")
    assert isinstance(read, SweepTable)
    assert read == results_of(document, str(tmp_path / "a.sqlite"))


def test_a_store_without_a_sweep_says_what_to_do(tmp_path: Path) -> None:
    with Store.to_write(tmp_path / "a.sqlite"):
        pass
    with pytest.raises(UserError, match=r"store is empty; .* rl-tui sweep --store"):
        read_results(tmp_path / "a.sqlite")
