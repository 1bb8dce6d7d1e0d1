# SPDX-License-Identifier: Apache-2.0
"""Links without mass as parts of what they are fixed to. As bodies of their own they would be so light beside their neighbors that
steps become short, slow and inaccurate."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from iota import looks
from iota._core import Sphere
from iota.shapelib.frames import Frame, LinkSolid, share_of, solid_of, sum_of
from iota.shapelib.mechanism_data import Link, Mechanism

LIGHT = 1e-4  # largest share of the heaviest link's mass in what is fixed to it, of links that become parts of it
SHARE = 1e-3  # of a neighbor's mass and inertia, for a link without mass between moving joints
MARK = 1e-3  # m, radius of the ball that stands for a link without shapes


class Tree:
    """Links from the roots down. parent: of each link but the roots, None for the world. is_fixed: of links that do not move
    relative to their parents. held: roots that the world holds."""

    def __init__(self, links: list[Link], parent: dict[str, str | None], fixed: set[str], held: set[str]) -> None:
        self.links = {link.name: link for link in links}
        self.parent, self.fixed, self.held = parent, fixed, held
        self.host: dict[str, str] = {}
        self.parts: dict[str, list[str]] = {}  # of each host, with itself
        self.static: set[str] = set()
        self.children: dict[str, list[str]] = {}
        for name in self.links:
            above = parent.get(name)
            if above is not None:
                self.children.setdefault(above, []).append(name)

    def mass(self, name: str) -> float:
        solid = self.links[name].solid
        return solid.mass if solid is not None else 0.0

    def groups(self) -> Iterator[list[str]]:
        """Links that are fixed to each other, from the top one down."""
        for top in self.links:
            if top in self.fixed and self.parent[top] is not None:
                continue
            group = [top]
            for name in group:
                group += [child for child in self.children.get(name, ()) if child in self.fixed]
            yield group

    def choose_hosts(self) -> None:
        """Chooses the link that each one is a part of: itself for one with mass, or alone."""
        for group in self.groups():
            top = group[0]
            heaviest = max(map(self.mass, group))
            light = {name for name in group if self.mass(name) <= LIGHT * heaviest}
            if len(light) == len(group):
                self.host |= dict.fromkeys(group, top)
                if top in self.held or top in self.fixed:  # by the world
                    self.static.add(top)
                continue
            # A light top is a part of the heaviest link that it holds, without another one with mass between them.
            near = [top]
            for name in near:
                if name in light:
                    near += [child for child in self.children.get(name, ()) if child in self.fixed]
            first = max((name for name in near if name not in light), key=self.mass)
            for name in group:
                above = self.parent.get(name)
                self.host[name] = name if name not in light else first if name == top else self.host[above or ""]

    def nearest_with_mass(self, name: str) -> tuple[LinkSolid, Link, bool] | None:
        """The heaviest of the next links with mass that it carries; else the next one that carries it; else the heaviest of
        all. And whether it carries that."""
        below = [name]
        found: list[Link] = []
        for each in below:
            carried = {self.host[child]: None for one in self.parts[each] for child in self.children.get(one, ())}
            for child in carried:
                if child == each:
                    continue
                link = self.links[child]
                found.append(link) if link.solid is not None else below.append(child)
        heaviest = max(found, key=lambda link: self.mass(link.name), default=None)
        if heaviest is not None and heaviest.solid is not None:
            return heaviest.solid, heaviest, True
        above = self.parent.get(name)
        while above is not None:
            link = self.links[self.host[above]]
            if link.solid is not None and link.kind != "static":
                return link.solid, link, False
            above = self.parent.get(link.name)
        links = [link for link in self.links.values() if link.solid is not None and link.kind != "static"]
        heaviest = max(links, key=lambda link: self.mass(link.name), default=None)
        return None if heaviest is None or heaviest.solid is None else (heaviest.solid, heaviest, False)


def fold(mechanism: Mechanism, tree: Tree) -> list[Link]:
    """Makes links without mass parts of others, gives a mass to those that are left, and notes both. Links that are bodies stay in
    `mechanism.links`. Returns those without a mass of their own."""
    tree.choose_hosts()
    folded = []
    for name, host in tree.host.items():
        tree.parts.setdefault(host, []).append(name)
    for name, host in tree.host.items():
        if host != name:
            _move_shapes(tree.links[name], tree.links[host])
            mechanism.places.append((name, host, tree.links[name].frame))
            folded.append(f"{name} ({host})")
    _add_masses(tree)
    bare = [link for name, link in tree.links.items() if tree.host[name] == name and link.solid is None]
    if folded:
        what = "1 link without mass is part of the one that it is" if len(folded) == 1 else (
            f"{len(folded)} links without mass are parts of those that they are"
        )  # fmt: skip
        mechanism.notes.append(f"{what} fixed to: {_listed(folded)}")
    for name in tree.static:
        link = tree.links[name]
        link.kind, link.solid = "static", solid_of(1.0, np.eye(3), Frame())
    mechanism.links = [link for link in mechanism.links if tree.host.get(link.name, link.name) == link.name]
    given = _give_masses(tree, [link for link in bare if link.solid is None])
    if given:
        what = "1 link has no mass, and" if len(given) == 1 else f"{len(given)} links have no mass, and"
        mechanism.notes.append(f"{what} a thousandth of a neighbor's: {_listed(given)}")
    return bare


def keep_names(mechanism: Mechanism, tree: Tree) -> None:
    """Lets joints and ropes hold the links of which theirs are now parts, and leaves out those within one."""
    kept = []
    for joint in mechanism.joints:
        joint.a = tree.host.get(joint.a, joint.a)
        joint.b = None if joint.b is None else tree.host.get(joint.b, joint.b)
        if joint.kind != "weld" or (joint.a != joint.b and joint.a not in tree.static):
            kept.append(joint)
    mechanism.joints = kept
    for spring in mechanism.springs:
        (a, p), (b, q) = spring.ends
        spring.ends = ((tree.host.get(a, a), p), (tree.host.get(b, b), q))
    mechanism.ropes = [
        (name, [(tree.host.get(link, link), place) for link, place in ends], length)
        for name, ends, length in mechanism.ropes
    ]


def mark(link: Link) -> None:
    """Gives a link without shapes one that is hardly seen."""
    if not link.drawn and not link.touching:
        link.drawn = [(looks.sphere(MARK), Frame())]
        link.touching = [(Sphere(MARK), Frame())]
        link.touches = False


def _listed(names: list[str]) -> str:
    return ", ".join(names[:5]) + (" ..." if len(names) > 5 else "")


def _move_shapes(link: Link, host: Link) -> None:
    there = host.frame.inverse() @ link.frame
    host.drawn += [(look, there @ place) for look, place in link.drawn]
    host.touching += [(shape, there @ place) for shape, place in link.touching]
    if link.material is not None and link.touching:
        names = {**(host.material or {}), **link.material}
        host.material = {
            name: max((link.material or {}).get(name, 0.0), (host.material or {}).get(name, 0.0)) for name in names
        }


def _add_masses(tree: Tree) -> None:
    """Adds the masses of light links to those of which they are parts."""
    parts: dict[str, list[Link]] = {}
    for name, host in tree.host.items():
        if tree.links[name].solid is not None:
            parts.setdefault(host, []).append(tree.links[name])
    for host, links in parts.items():
        if len(links) > 1:
            back = tree.links[host].frame.inverse()
            solids = [link.solid for link in links if link.solid is not None]
            tree.links[host].solid = sum_of(solids, [back @ link.frame for link in links])


def _give_masses(tree: Tree, bare: list[Link]) -> list[str]:
    """Returns the names with the masses. That which a link carries gives it a share of its own mass and inertia, so that their sum stays."""
    found = [(link, tree.nearest_with_mass(link.name)) for link in bare]
    given: list[str] = []
    taken: dict[str, tuple[int, Link]] = {}
    for link, near in found:
        if near is None:
            link.solid = solid_of(1.0, 1e-2 * np.eye(3), Frame())
            given.append(f"{link.name} (1 kg, as no link has a mass)")
            continue
        solid, of, is_carried = near
        there = link.frame.inverse() @ of.frame @ solid.frame
        # One that carries nothing has its center at its own place.
        link.solid = LinkSolid(SHARE * solid.mass, there if is_carried else Frame(turn=there.turn), solid.shape, False)
        if is_carried:
            count, _ = taken.get(of.name, (0, of))
            taken[of.name] = (count + 1, of)
        given.append(f"{link.name} ({link.solid.mass:.3g} kg)")
    for count, of in taken.values():
        assert of.solid is not None
        of.solid = share_of(of.solid, 1 - min(count * SHARE, 0.5))
    return given
