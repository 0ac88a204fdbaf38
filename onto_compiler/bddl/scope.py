"""The names of a task and their classes: what each object, fixture and region is, by the TBox."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from onto_compiler.bddl.ast import Region, TaskSpec
from onto_compiler.required import Entity
from onto_compiler.schema import Schema

__all__ = ["Named", "Scope", "scope_of"]


@dataclass(frozen=True, slots=True)
class Named:
    """A name with its class. For a region, ``category`` is its target's and ``region`` is its declaration."""

    entity: Entity
    category: str
    region: Region | None = None


@dataclass(frozen=True, slots=True)
class Scope:
    """Every name that an atom may use. ``orphans`` are sites of regions whose target nobody declared."""

    names: Mapping[str, Named]
    orphans: Mapping[str, Region]

    def landmark(self, name: str) -> Entity | None:
        """What ``name`` stands for: the instance of that name, or else the only instance of that category."""
        exact = self.names.get(name)
        if exact is not None and exact.region is None:
            return exact.entity
        of_category = [each.entity for each in self.names.values() if each.region is None and each.category == name]
        return of_category[0] if len(of_category) == 1 else None


def scope_of(spec: TaskSpec, schema: Schema) -> Scope:
    """Type every declaration of ``spec`` by ``schema``."""
    names = dict(_instances(spec, schema))
    orphans: dict[str, Region] = {}
    regions: dict[str, Named] = {}
    for region in spec.regions:
        target = names.get(region.target.name)
        if target is None:
            orphans[region.site] = region
            continue
        cls = schema.regions.get((target.category, region.name)) or _default_region(target, schema)
        regions[region.site] = Named(Entity(region.site, cls), target.category, region)
    return Scope(names | regions, orphans)


def _instances(spec: TaskSpec, schema: Schema) -> Iterator[tuple[str, Named]]:
    for default, declarations in (("fixture", spec.fixtures), ("object", spec.objects)):
        for each in declarations:
            cls = schema.categories.get(each.category) or schema.defaults[default]
            yield each.name, Named(Entity(each.name, cls), each.category)


def _default_region(target: Named, schema: Schema) -> str:
    workspace = schema.defaults.get("workspace")
    if workspace is not None and schema.is_a(target.entity.type, workspace):
        return schema.defaults["workspace_region"]
    return schema.defaults["region"]
