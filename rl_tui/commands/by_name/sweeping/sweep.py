"""``rl-tui sweep``: train many settings, each under many seeds."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from rl_tui.commands.line.output import WORTH_A_FORECAST, complain, finish_compiling, progress
from rl_tui.commands.options.run import (
    CsvTarget,
    OptionValue,
    SectionedCommand,
    Whole,
    allow_module_option,
    check_targets,
    is_stdout,
    json_option,
    run_options,
    scenario_argument,
    seed_option,
    target_option,
)
from rl_tui.common.limits import MOST_SWEEP_CELLS, MOST_SWEEP_EPISODES, MOST_SWEEP_RUNS
from rl_tui.common.words import counted, lasting, short_count

if TYPE_CHECKING:
    from rl_tui.runs.measures import Measure
    from rl_tui.studies.sweeps.cells.variation import Variation
    from rl_tui.studies.sweeps.plan import Shard, SweepPlan
    from rl_tui.studies.sweeps.store import Store
    from rl_tui.studies.sweeps.sweep import SweepProgress, Workers

    MakeWorkers = Callable[[Callable[[str], None]], Workers]

_STORE: Final = click.Path(dir_okay=False, path_type=Path)
MOST_SHARDS: Final = 100_000
_ADDRESS: Final = re.compile(r"(?:tcp|tls)://(?:[\w.-]+|\[[0-9a-fA-F:.]+\]):\d{1,5}", re.ASCII)


# Values of options


class VariationValue(OptionValue):
    """A setting and its values: NAME=FROM:TO[:log]:COUNT or NAME=A,B,C."""

    name = "NAME=FROM:TO[:log]:COUNT|NAME=A,B,C"

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """Return the placeholder for the help text."""
        return self.name

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> Variation:
        """Parse a variation."""
        from rl_tui.studies.sweeps.cells.variation import Variation, read_variation

        if isinstance(value, Variation):
            return value
        try:
            return read_variation(str(value))
        except ValueError as fault:
            self.fail(str(fault), param, ctx)


class ShardValue(OptionValue):
    """One part of a sweep, I/N."""

    name = "I/N"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> Shard:
        """Parse a shard."""
        from rl_tui.studies.sweeps.plan import Shard

        if isinstance(value, Shard):
            return value
        found = re.fullmatch(r"(\d{1,6})/(\d{1,6})", str(value), re.ASCII)
        number, count = (int(found[1]), int(found[2])) if found else (0, 0)
        if not 1 <= number <= count <= MOST_SHARDS:
            self.fail(f"{value} is not a part I/N, with I from 1 to N, such as 1/3", param, ctx)
        return Shard(number, count)


class MeasureValue(OptionValue):
    """The id of a metric."""

    name = "MEASURE"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> Measure:
        """Parse a metric, or fail with all metrics."""
        from rl_tui.runs.measures import Measure
        from rl_tui.studies.sweeps.cell import MEASURES

        if isinstance(value, Measure):
            return value
        if str(value) not in MEASURES:
            self.fail(f"unknown metric {value}; expected one of {', '.join(MEASURES)}", param, ctx)
        return MEASURES[str(value)]


class SchedulerValue(OptionValue):
    """The address of a Dask scheduler."""

    name = "ADDRESS"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Parse an address."""
        if not _ADDRESS.fullmatch(str(value)):
            self.fail(f"{value} is not the address of a Dask scheduler, such as tcp://node1:8786", param, ctx)
        return str(value)


# The commands


@click.command("merge")
@click.argument("out", metavar="OUT.sqlite", type=_STORE)
@click.argument("stores", metavar="IN.sqlite...", type=_STORE, nargs=-1, required=True)
def merge_command(out: Path, stores: tuple[Path, ...]) -> None:
    """Merge the runs of several stores into one.

    A run that is in two stores is kept once. Different results of the same run are an error, if both stores
    come from the same kind of machine (system, processor, versions). Otherwise the first result is kept. An
    example:

    rl-tui sweep merge all.sqlite part1.sqlite part2.sqlite part3.sqlite
    """
    from rl_tui.studies.sweeps.merge import merge

    with progress("merging") as bar:
        merged = merge(out, stores, bar)
    click.echo(f"{out}: {counted(merged.new, 'new run')}, {merged.same:,} already there")
    if merged.kept:
        complain(f"{counted(merged.kept, 'run')} differ from another machine's; the first results are kept")


class SweepCommand(SectionedCommand):
    """``sweep``, with the subcommand ``sweep merge``."""

    def make_context(
        self, info_name: str | None, args: list[str], parent: click.Context | None = None, **extra: Any
    ) -> click.Context:
        """Return the context of either command."""
        if args[:1] == [merge_command.name]:
            return merge_command.make_context(f"{info_name} {args[0]}", args[1:], parent=parent, **extra)
        return super().make_context(info_name, args, parent=parent, **extra)


@click.command("sweep", cls=SweepCommand)
@scenario_argument
@click.option(
    "--vary",
    "variations",
    type=VariationValue(),
    multiple=True,
    required=True,
    help=(
        "vary a setting, algorithm, policy, scenario or world.KEY. Give a list A,B,C, or COUNT values "
        "from FROM to TO (:log for equal ratios). Repeat the option to train all combinations"
    ),
)
@click.option(
    "--runs",
    type=Whole(1, MOST_SWEEP_RUNS),
    default=10,
    show_default=True,
    help="number of runs per combination, with consecutive seeds",
)
@click.option(
    "--random", type=Whole(1, MOST_SWEEP_CELLS), help="number of random combinations, instead of all"
)
@click.option(
    "--episodes",
    type=Whole(1, MOST_SWEEP_EPISODES),
    help="number of episodes to train  [default: the scenario's]",
)
@click.option("--store", type=_STORE, help="store the runs in FILE.sqlite, and train only missing ones")
@click.option("--jobs", type=Whole(1, 4096), help="number of runs trained at once  [default: one per core]")
@click.option(
    "--dask",
    type=SchedulerValue(),
    help="train on the workers of the Dask scheduler at tcp://HOST:PORT. Use a network that "
    "you trust: Dask executes code that it receives",
)
@click.option(
    "--shard", type=ShardValue(), help="train only part I of N, while other machines train the rest"
)
@click.option(
    "--measure",
    type=MeasureValue(),
    help="metric that compares settings: area (mean return of all episodes), arrival (episodes until almost "
    "as good as the best), expected_return, value_at_start, max_error, regret, steps, episodes, "
    "return_last_100",
)
@click.option("--no-again", is_flag=True, help="do not train the best combination again with fresh seeds")
@target_option("--csv", "one row per run: settings, seed and metrics")
@allow_module_option
@run_options
@seed_option
@json_option
def command(
    scenario: str,
    variations: tuple[Variation, ...],
    runs: int,
    random: int | None,
    episodes: int | None,
    store: Path | None,
    jobs: int | None,
    dask: str | None,
    shard: Shard | None,
    measure: Measure | None,
    no_again: bool,
    csv: CsvTarget,
    overrides: dict[str, object],
    seed: int,
    as_json: bool,
) -> None:
    """Train all combinations of settings, and find the best.

    All train under the same seeds. With a store, an interrupted sweep continues where it stopped, and a
    larger sweep trains only the new runs. An example:

    rl-tui sweep cliff --vary alpha=0.05:1:20 --vary algorithm=q-learning,sarsa --store cliff.sqlite

    To merge stores of several machines: rl-tui sweep merge --help
    """
    check_targets({"--csv": csv, "--store": store}, as_json)
    for each in variations:
        if each.name in overrides:
            raise click.UsageError(
                f"give --vary {each.name} or --{each.name.replace('_', '-')}, not both",
                click.get_current_context(),
            )
    _check_shard(shard, store, has_output=as_json or csv is not None)
    if dask is not None and jobs is not None:
        raise click.UsageError(
            "leave out --jobs: with --dask, each worker uses all of its threads",
            click.get_current_context(),
        )
    from rl_tui.runs.library import find
    from rl_tui.studies.sweeps.plan import WHOLE, SweepPlan
    from rl_tui.studies.sweeps.store import Store

    plan = SweepPlan(find(scenario), variations, overrides, episodes, runs, seed, random, seed)
    plan.check()
    for name in plan.without_effect():
        complain(f"{name} has no effect: no agent of this sweep uses it")
    with Store.without_file() if store is None else Store.to_write(store) as kept:
        workers = partial(_workers, jobs, dask)
        done = _train(plan, kept, shard or WHOLE, workers, is_kept=store is not None)
        if shard is None:
            _report(plan, kept, done, measure, workers, csv, again=not no_again, as_json=as_json)
        else:
            click.echo(
                f"part {shard.number} of {shard.parts} is done: {counted(done.done, 'run')} in {store}; "
                f"rl-tui sweep merge puts all parts together"
            )
    if store is not None and shard is None and not as_json:
        click.echo(
            f"\n{store} keeps the runs. To draw them: rl-tui plot {store}",
            err=is_stdout(csv),
        )
    finish_compiling()


def _check_shard(shard: Shard | None, store: Path | None, *, has_output: bool) -> None:
    if shard is None:
        return
    if store is None:
        raise click.UsageError(
            "--shard without --store would lose its results; give each part its own --store",
            click.get_current_context(),
        )
    if has_output:
        raise click.UsageError(
            "--shard prints no results: merge all parts, then repeat the command without --shard",
            click.get_current_context(),
        )


def _workers(jobs: int | None, dask: str | None, tell: Callable[[str], None]) -> Workers:
    # `jobs` threads of this machine, or the workers of a Dask cluster
    if dask is not None:
        from rl_tui.studies.sweeps.cluster.dask_workers import DaskWorkers

        return DaskWorkers(dask, tell=tell)
    from rl_tui.studies.sweeps.sweep import ThreadWorkers

    return ThreadWorkers(jobs)


def _complain_below_bar(message: str) -> None:
    complain(f"\n{message}" if sys.stderr.isatty() else message)


def _train(
    plan: SweepPlan, store: Store, shard: Shard, workers: MakeWorkers, *, is_kept: bool
) -> SweepProgress:
    from rl_tui.studies.sweeps.sweep import SweepProgress, run_sweep

    latest = SweepProgress(plan.size_of(shard) * plan.runs)
    with progress(f"{plan.scenario.id}, {counted(plan.count, 'cell')}") as bar:

        def on_progress(now: SweepProgress) -> None:
            nonlocal latest
            latest = now
            bar.show(now.done, now.planned, _how_far(now))

        try:
            return run_sweep(
                plan, store, shard=shard, workers=workers(_complain_below_bar), on_progress=on_progress
            )
        except KeyboardInterrupt:
            kept = f"kept in {store.name}: repeat the command to continue"
            where = kept if is_kept else "lost; --store would keep them"
            _complain_below_bar(
                f"interrupted: {latest.done:,} of {counted(latest.planned, 'run')} are {where}"
            )
            raise


def _how_far(now: SweepProgress) -> str:
    parts = [f"{short_count(now.done)} of {short_count(now.planned)} runs"]
    if now.seconds >= WORTH_A_FORECAST and now.trained and now.done < now.planned:
        parts.append(f"{short_count(int(now.steps / now.seconds))} steps/s")
        parts.append(f"{lasting((now.planned - now.done) * now.seconds / now.trained)} left")
    return ", ".join(parts)


def _report(
    plan: SweepPlan,
    store: Store,
    done: SweepProgress,
    measure: Measure | None,
    workers: MakeWorkers,
    csv: CsvTarget,
    *,
    again: bool,
    as_json: bool,
) -> None:
    from rl_tui.common.files import file_or_stream
    from rl_tui.studies.sweeps.document import best_documents, json_pieces, write_csv
    from rl_tui.studies.sweeps.ranking import standings_of
    from rl_tui.studies.sweeps.sweep import run_again

    standings = standings_of(plan, store, measure)
    if again:
        for cell in standings.chosen:
            run_again(plan, cell, store, workers(complain))
    bests = best_documents(standings, plan, store, again=again)
    if csv is not None:
        with file_or_stream(csv) as stream:
            write_csv(stream, plan, store)
    if as_json:
        rate = done.steps / done.seconds if done.steps and done.seconds else None
        for piece in json_pieces(plan, store, standings, bests, seconds=done.seconds, steps_per_second=rate):
            click.echo(piece, nl=False)
        return
    from rl_tui.commands.reports.sweep import sensitivity_report, sweep_report
    from rl_tui.studies.sweeps.document import sensitivities

    reports = (
        sweep_report(plan, store, standings, bests, done.failed),
        sensitivity_report(sensitivities(plan, store, standings.measure)),
    )
    click.echo("\n\n".join(filter(None, reports)), err=is_stdout(csv))
