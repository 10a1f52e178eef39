"""Figures of a roller that wears: the two profiles at five travels, and the course of depth,
pressure and damage.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.parameters import BODIES
from trackroller.report.figures import style
from trackroller.report.numbers import rounded
from trackroller.results.wear_answer import deeper_contact

TRAVELS = 5  # profiles drawn side by side
ROOM = 1.25  # width drawn over the half width of the widest patch


def profiles(ds: xr.Dataset) -> style.Drawn:
    """Draw roller and guide over the new guide at five travels, magnified normal to the surface.

    Parameters
    ----------
    ds : result of `trackroller.wear`

    Returns
    -------
    The figure and its caption.
    """
    contact = deeper_contact(ds)
    own = ds.sel(contact=contact)
    travel = own["travel"].values
    outward = -1
    if contact == 1:
        outward = 1
    goals = np.linspace(travel[0], travel[-1], TRAVELS)
    shown = sorted({int(np.argmin(np.abs(travel - goal))) for goal in goals})
    middle, half = outward * own["pressure_centre"].values, own["semi_axis_lateral"].values
    reach = ROOM * float(np.max(np.abs(middle) + half))
    near = own.sel(place=slice(-reach, reach))
    figure, panels = style.panels(
        f"Profiles of contact {contact} while they wear", 62, len(shown), sharex=True, sharey=True
    )
    colours = style.PAIR
    for axes, row in zip(panels, shown, strict=True):
        surfaces = {b: 1e3 * near[f"{b}_surface"].isel(travel=row).values for b in BODIES}
        axes.axvspan(middle[row] - half[row], middle[row] + half[row], color="0.93", zorder=0)
        for body, colour, line in zip(BODIES, colours, style.LINES, strict=False):
            axes.plot(near["place"], surfaces[body], color=colour, ls=line, lw=1.2, label=body)
        if row == shown[0]:
            new = surfaces["roller"]
        else:
            axes.plot(near["place"], new, color=colours[0], lw=0.6, alpha=0.5, label="new roller")
        axes.set_title(f"{rounded(float(travel[row]))} km")
    panels[0].set_ylabel("height over the new guide [µm]")
    panels[len(shown) // 2].set_xlabel("lateral place, outward [mm]")
    panels[-1].legend(loc="upper center", frameon=False)
    magnified = reach * 1e3 / max(float(np.ptp(new)), 1e-9)
    caption = (
        "Worn surfaces of roller and guide over the new surface of the guide, moved together "
        "until they touch. Grey: width of the patch under load. Heights are magnified about "
        f"{rounded(magnified, 1)} times."
    )
    depth = 1e3 * float(own["groove_depth"].isel(travel=-1).sum("body"))
    wide = f"The patch grows from {rounded(2 * half[0])} to {rounded(2 * half[-1])} mm"
    return figure, style.FigureInfo(
        "wear_profiles", caption, f"{wide} while {rounded(depth)} µm are worn off."
    )


def over_patch(ds: xr.Dataset) -> style.Drawn:
    """Draw the depth over both patches after the run-in distance, at the rate of the new profiles.

    Parameters
    ----------
    ds : result of `solve` for one case
        With the outputs `tractions` and `wear`, by Archard's law. Otherwise no figure is drawn.

    Returns
    -------
    The figure and its caption, or None.
    """
    names = {"run_in_distance", "wear_depth_per_km", "pressure", "slip_lateral", "slip_rolling"}
    if (
        not names <= set(ds)
        or ds.attrs.get("wear_law") != "archard"
        or not np.isfinite(float(ds["run_in_distance"]))
    ):
        return None
    rate = (ds["pressure"] * np.hypot(ds["slip_lateral"], ds["slip_rolling"])).sum("y")
    shape = rate / rate.max("x")
    figure = style.new_figure(38, 88)
    panels = figure.subplots(1, ds.sizes["contact"], sharey=True, squeeze=False)[0]
    for axes, contact in zip(panels, ds["contact"].values.tolist(), strict=True):
        for body, colour, line in zip(BODIES, style.PAIR, style.LINES, strict=False):
            own = ds.sel(contact=contact, body=body)
            depth = 1e3 * float(own["run_in_distance"] * own["wear_depth_per_km"])
            if np.isfinite(depth):
                x = ds["patch_x"].sel(contact=contact)
                axes.plot(
                    x, depth * shape.sel(contact=contact), color=colour, ls=line, lw=1.2, label=body
                )
        axes.set(title=f"contact {contact}", xlabel="lateral place [mm]")
    # room for the legend
    panels[0].set(ylabel="worn depth [µm]", ylim=(0.0, 1.5 * panels[0].get_ylim()[1]))
    panels[-1].legend(frameon=False, loc="upper left")
    caption = (
        f"Worn depth after the run-in distance of {rounded(float(ds['run_in_distance']))} "
        "km, at the first rate."
    )
    return figure, style.FigureInfo("wear_depth", caption, "")


def course(ds: xr.Dataset) -> style.Drawn:
    """Draw depth, largest pressure and damage sum over the travel.

    Parameters
    ----------
    ds : result of `trackroller.wear`

    Returns
    -------
    The figure and its caption.
    """
    travel = ds["travel"].values
    contacts = ds["contact"].values.tolist()
    rows = [("groove_depth", "depth [µm]", 1e3), ("max_pressure", "largest pressure [MPa]", 1.0)]
    if "fatigue_damage" in ds:
        rows += [("fatigue_damage", "damage sum [–]", 1.0)]
    figure, panels = style.panels("Depth, pressure and fatigue over the travel", 58, len(rows))
    for axes, (name, words, scale) in zip(panels, rows, strict=True):
        for body, colour in zip(BODIES, style.PAIR, strict=False):
            for contact, line in zip(contacts, style.LINES, strict=False):
                own = ds[name].sel(contact=contact)
                of = f"contact {contact}"
                look = {"color": "0.25", "ls": line, "marker": "."}
                if "body" in own.dims:
                    own = own.sel(body=body)
                    of = f"{body}, contact {contact}"
                    look["color"] = colour
                elif body == BODIES[1]:
                    continue
                values = scale * own.values
                if not np.isnan(values).all():
                    axes.plot(travel, values, label=of, **look)
        axes.set(title=words, xlabel="travel [km]")
        # room for the legend
        head_room = 1.0
        if "body" in ds[name].dims:
            head_room = 1.6
        axes.set_ylim(0.0, head_room * axes.get_ylim()[1])
        axes.legend(frameon=False)
    error = 1e3 * float(ds["groove_depth_error"][-1])
    relative = 100 * float(ds["pressure_error"].max())
    caption = (
        "Points are solved states. Steps and elements cause an estimated error of the depth of "
        f"{rounded(error, 2)} µm, and of the pressure of {rounded(relative, 2)} % at most."
    )
    return figure, style.FigureInfo("wear_course", caption, "")
