"""A profile as the text that `read_profile` takes."""

from __future__ import annotations

from fmus.profiles.profile import Profile


def as_text(profile: Profile) -> str:
    """CSV in mm, with what it is and what its signs mean above; to a thousandth of a micrometre."""
    lines = [
        *(f"# {line.replace('=', ':')}" for line in profile.said),
        f"# profile = {profile.kind}",
        "# y positive = outside",
        "# z positive = up",
        "y [mm],z [mm]",
        *(f"{y:.6f},{z:.6f}" for y, z in 1e3 * profile.points),
    ]
    return "\n".join(lines) + "\n"
