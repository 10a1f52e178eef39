"""The report of a study: one HTML file that works by mail, on a screen and on paper."""

from __future__ import annotations

import base64
import json
import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller import parameters
from trackroller.report.decisions import decisions
from trackroller.report.figures import style
from trackroller.report.figures.study_loads import surface_share
from trackroller.report.figures.study_view import StudyView, study_settings
from trackroller.report.inputs import base_table, factor_table, materials_table, record_table
from trackroller.report.papers import conventions, papers
from trackroller.report.tables import causes, design_rows, only_model, ranked, reasons, regime_table, validity_table

if TYPE_CHECKING:
    import xarray as xr

log = logging.getLogger(__name__)
SAMPLED = ("lhs", "sobol", "morris", "saltelli", "inner_outer")  # designs that `samples` counts for
MAX_SVG = 1_500_000  # bytes; a larger drawing goes in as PNG
OPTIONS = tuple(option.name for option in parameters.OPTIONS.values() if option.recorded)
_TOLD = {
    "study",
    "materials",
    "comment",
    "title",
    "coordinates",
    "Conventions",
    "life_conventions",
    "sign_conventions",
    "design",
    *OPTIONS,
}


def write_report(study_nc: Path, figures_dir: Path, out_html: Path, sensitivity_nc: Path | None = None) -> Path:
    """Write the report of a gathered study as one self-contained HTML file.

    Parameters
    ----------
    study_nc : gathered study
    figures_dir : folder with the figures and their `index*.json`; may be empty or missing
    out_html : the file to write; written whole or not at all
    sensitivity_nc : analysis of the study, when there is one

    Returns
    -------
    The path written.
    """
    import jinja2
    import markupsafe
    import xarray as xr

    from trackroller.report.pages import inline

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("trackroller.report", "templates"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["marked"] = lambda text: markupsafe.Markup(inline(str(text)))
    with xr.open_dataset(study_nc) as ds:
        content = contents(ds) | decisions(ds, sensitivity_nc)
    content["figures"] = figures(Path(figures_dir))
    content["summary"] += content["models"].get("short", [])
    text = environment.get_template("report.html.j2").render(content)
    out_html = Path(out_html)
    out_html.parent.mkdir(parents=True, exist_ok=True)
    part = out_html.with_name(f".{out_html.name}.part")
    part.write_text(text, encoding="utf-8")
    part.replace(out_html)
    return out_html


def contents(ds: xr.Dataset) -> dict[str, Any]:
    """Everything the template needs from the gathered study."""
    view = StudyView.of(ds)
    attrs, results = dict(ds.attrs), set(map(str, ds.data_vars))
    settings = study_settings(attrs)
    merged = {**{k: settings[k] for k in (*OPTIONS, "design") if k in settings}, **attrs}
    order = ranked(view)
    return {
        "name": str(settings.get("name") or attrs.get("study_name") or "Parameter study"),
        "description": str(settings.get("description") or attrs.get("comment") or ""),
        "cases": len(view.table),
        "design": str(merged.get("design", "grid" if view.grid else "sample")),
        "samples": settings.get("samples") if str(merged.get("design")) in SAMPLED else None,
        "date": str(attrs.get("date_created") or attrs.get("date") or attrs.get("created") or ""),
        "factors": factor_table(view),
        "base": base_table(view, ds),
        "options": [(style.capital(style.long_name(k)), told) for k in OPTIONS if (told := _told(merged.get(k, "")))]
        + models_used(ds),
        "materials": materials_table(attrs),
        "regimes": regime_table(view),
        "validity": validity_table(view, ds),
        "reasons": reasons(ds),
        "solution": solution_facts(ds, view),
        "ranked_by": order[0] if order else "",
        "ranked_model": only_model(view) or "",
        "best": design_rows(view, order[1]) if order and len(order[1]) else [],
        "worst": design_rows(view, order[2]) if order else [],
        "summary": summary(view),
        "conventions": conventions(merged, results),
        "papers": papers(merged, results),
        "record": record_table(attrs, _TOLD),
        "study_text": str(attrs.get("study", "")),
    }


def _told(value: Any) -> str:
    """An option as a reader wants it: a list, as of a factor or of terms, as its entries."""
    return ", ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)


def summary(view: StudyView) -> list[str]:
    """The plain sentences at the head of the report."""
    table, said = view.table, []
    if "regime" in table:
        regime = table["regime"].to_numpy()
        counts = [f"{int((regime == c).sum())} {n}" for c, n in enumerate(style.REGIME_LABELS) if (regime == c).any()]
        said.append(f"{len(table)} cases: {', '.join(counts)}.")
        for code in (1, 2, 3):
            if why := causes(view, regime == code):
                said.append(f"{style.capital(style.REGIME_LABELS[code])} goes with {'; '.join(why)}.")
    if view.has("stopped") and (stopped := int((table["stopped"] == 1).sum())):
        said.append(f"{stopped} of {len(table)} cases met the condition of stop_if: no stress and no life was sought.")
    if view.life is not None:
        column, words, unit = view.life
        life = table[column].to_numpy()
        good = life[np.isfinite(life)]
        if good.size:
            endless = int(np.isposinf(life).sum())
            half = style.number(float(np.median(life[~np.isnan(life)])))
            text = f"{words}: from {style.number(good.min())} to {style.number(good.max())} {unit}"
            said.append(f"{text}, half of the cases below {half} {unit}{f', {endless} unlimited' if endless else ''}.")
    for body in ("roller", "guide"):
        if view.has(f"peak_stress_{body}"):
            peak = table[f"peak_stress_{body}"].to_numpy()
            low, high = style.number(np.nanmin(peak)), style.number(np.nanmax(peak))
            text = f"Peak von Mises stress of the {body}: from {low} to {high} MPa"
            if view.has(f"at_surface_{body}"):
                text += f", {surface_share(view.table[f'at_surface_{body}'].to_numpy())}"
            said.append(text + ".")
    return said


def models_used(ds: xr.Dataset) -> list[tuple[str, str]]:
    """How many cases each contact model solved, where it was chosen case by case."""
    if "contact_model_used" not in ds:
        return []
    names = str(ds["contact_model_used"].attrs.get("flag_meanings", "")).split()
    used = ds["contact_model_used"].values.astype(float)
    if "contact_model" in ds.coords:
        asked = ds["contact_model"].broadcast_like(ds["contact_model_used"]).transpose(*ds["contact_model_used"].dims)
        used = used[asked.values.astype(str) == "auto"]
    elif ds.attrs.get("contact_model", "auto") != "auto":
        return []
    counts = [(name, int((used == i).sum())) for i, name in enumerate(names)]
    said = ", ".join(f"{name} in {count}" for name, count in counts if count)
    return [("Contact model chosen", f"{said} of {used.size} cases")] if said and len(set(used.ravel())) > 1 else []


def solution_facts(ds: xr.Dataset, view: StudyView) -> list[tuple[str, str]]:
    """How well the cases are solved."""
    rows = []
    if "converged" in view.table:
        rows.append(("Converged cases", f"{int((view.table['converged'] == 1).sum())} of {len(view.table)}"))
    for name, words in (
        ("residual", "Largest relative residual of the equilibrium"),
        ("error_estimate", "Largest estimated relative error of the peak stress"),
    ):
        if name in ds and ds[name].dtype.kind == "f":
            values = ds[name].values
            if np.isfinite(values).any():
                good = values[np.isfinite(values)]
                text = style.rounded(float(good.max()), 2)
                if name == "error_estimate" and good.max() > 0.01:
                    text += f" (half of the peaks below {style.rounded(float(np.median(good)), 2)})"
                rows.append((words, text))
    return rows


def figures(folder: Path) -> list[dict[str, str]]:
    """Figures of a folder as data URIs with captions: those of its indices first, then what else lies there."""
    listed: list[dict[str, Any]] = []
    for index in sorted(folder.glob("index*.json"), key=lambda p: (p.name != "index.json", p.name)):
        try:
            listed += json.loads(index.read_text(encoding="utf-8"))
        except (ValueError, OSError) as problem:
            log.warning("%s cannot be read: %s", index, problem)
    names = {str(item.get("name")) for item in listed}
    stems = sorted({p.stem for p in folder.glob("*.[sp][vn]g") if not p.name.startswith(".")} - names)
    listed += [{"name": s, "caption": style.plain(s), "sentence": ""} for s in stems]
    found = []
    for item in listed:
        if source := _data_uri(folder, str(item["name"])):
            found.append(
                {
                    "name": str(item["name"]),
                    "source": source,
                    "caption": str(item.get("caption", "")),
                    "sentence": str(item.get("sentence", "")),
                }
            )
    return found


def _data_uri(folder: Path, name: str) -> str:
    svg, png = folder / f"{name}.svg", folder / f"{name}.png"
    if svg.is_file() and (svg.stat().st_size <= MAX_SVG or not png.is_file()):
        return f"data:image/svg+xml;base64,{base64.b64encode(svg.read_bytes()).decode('ascii')}"
    if png.is_file():
        return f"data:image/png;base64,{base64.b64encode(png.read_bytes()).decode('ascii')}"
    return ""
