"""The command `tracktrain fmu test`: does an FMU do what it says of itself?"""

from __future__ import annotations

from pathlib import Path

import click

import orchestrator

from ....terminal import plain_console, plain_grid


@click.command(
    epilog="""\b
Examples:
  tracktrain fmu test my_truck.fmu
  tracktrain fmu test my_truck.fmu --set mass="3 t\""""
)
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--set",
    "values",
    multiple=True,
    metavar="VARIABLE=VALUE",
    help="Start value to test it with. Repeatable.",
)
@click.pass_context
def command(ctx: click.Context, file: Path, values: tuple[str, ...]) -> None:
    """Find out whether an FMU does what it says of itself.

    Tries it in a process of its own: that equal runs give equal bits, that a saved state holds
    everything, that outputs depend on the inputs that it names and on no other, that its
    derivatives are right, and that its units are known. The exit code is 1 if something is wrong,
    or could not be tested.
    """
    given = dict(_pair(text) for text in values)
    found = orchestrator.self_tests({"fmu": orchestrator.Component(file, given)}, anew=True)["fmu"]
    console, grid = plain_console(), plain_grid()
    for check in dict.fromkeys([*orchestrator.CHECKS, *(f.check for f in found.findings)]):
        said = [f for f in found.findings if f.check == check]
        if check not in found.passed and not said:
            grid.add_row(check, "not offered" if "start" in found.passed else "not tested")
            continue
        texts = [f"{'' if f.wrong else 'note: '}{f.text}" for f in said]
        head = ["passed"] if check in found.passed else []
        wrong = any(f.wrong for f in said)
        grid.add_row(check, "\n".join([*head, *texts]), style="red" if wrong else None)
    console.print(grid)
    console.print()
    if found.errors:
        console.print(f"{found.label} failed its self-test", style="bold red")
    elif found.untested:
        untested = ", ".join(dict.fromkeys(f.check for f in found.untested))
        message = f"{found.label} did not pass its self-test: not tested were {untested}"
        console.print(message, style="bold yellow")
    else:
        console.print(f"{found.label} passed its self-test", style="bold green")
        return
    ctx.exit(1)


def _pair(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise click.UsageError(f"--set '{text}' is no assignment; write it as VARIABLE=VALUE")
    return name, value
