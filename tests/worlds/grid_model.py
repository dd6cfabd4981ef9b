"""A slow and plain model of maps."""

from __future__ import annotations

from collections import defaultdict

STEPS = {
    "left": (0, -1),
    "down": (1, 0),
    "right": (0, 1),
    "up": (-1, 0),
    "down-left": (1, -1),
    "down-right": (1, 1),
    "up-right": (-1, 1),
    "up-left": (-1, -1),
    "stay": (0, 0),
}
AROUND = ["left", "down", "right", "up"]
SIZES = {"four": 4, "king": 8, "king+stay": 9}
BUILT_IN = {
    ".": {"kind": "floor"},
    "S": {"kind": "start"},
    "G": {"kind": "goal", "reward": 1.0},
    "H": {"kind": "hole"},
    "#": {"kind": "wall"},
    "<": {"kind": "floor", "only": ["left"]},
    ">": {"kind": "floor", "only": ["right"]},
    "^": {"kind": "floor", "only": ["up"]},
    "v": {"kind": "floor", "only": ["down"]},
}


class GridModel:
    def __init__(self, lines, legend=None, **rules):
        self.lines, self.rules = lines, rules
        self.legend = BUILT_IN | (legend or {})
        self.columns = len(lines[0])
        self.actions = list(STEPS)[: SIZES[rules.get("moves", "four")]]
        if any(self.legend[letter].get("exit") for line in lines for letter in line):
            self.actions.append("exit")
        self.starts = [cell for cell in self.cells() if self.at(cell)["kind"] == "start"]

    def cells(self):
        return [(row, column) for row, line in enumerate(self.lines) for column in range(len(line))]

    def at(self, cell):
        return self.legend[self.lines[cell[0]][cell[1]]]

    def number(self, cell):
        return cell[0] * self.columns + cell[1]

    def is_open(self, cell):
        row, column = cell
        inside = 0 <= row < len(self.lines) and 0 <= column < self.columns
        return inside and self.at(cell)["kind"] != "wall"

    def is_terminal(self, cell):
        entry = self.at(cell)
        by_kind = entry["kind"] in ("goal", "hole") and not entry.get("exit")
        return entry.get("terminal", by_kind)

    def pays(self, cell):
        entry = self.at(cell)
        return entry.get("reward", 1.0 if entry["kind"] == "goal" else 0.0)

    def outcomes(self, cell, action):
        """(happened, next number, reward, terminated) → probability."""
        entry, chances = self.at(cell), defaultdict(float)
        if (action == "exit") != bool(entry.get("exit")) or self.is_terminal(cell):
            return {}
        if action == "exit":
            return {("exit", self.number(cell), self.pays(cell), True): 1.0}
        if "jump" in entry:
            (target,) = [each for each in self.cells() if self.lines[each[0]][each[1]] == entry["jump"]]
            return {(action, *self.arrival(cell, target, bumped=False)): 1.0}
        for happened, chance in self.slips(action):
            for (down, right), share in self.winds(cell):
                landed, bumped = self.walk(cell, happened, down, right)
                chances[happened, *self.arrival(cell, landed, bumped)] += chance * share
        return {key: chance for key, chance in chances.items() if chance > 0.0}

    def slips(self, action):
        noise = 2 / 3 if self.rules.get("slippery") else self.rules.get("noise", 0.0)
        if not noise:
            return [(action, 1.0)]
        place = AROUND.index(action)
        sides = [AROUND[(place + 1) % 4], AROUND[(place + 3) % 4]]
        return [(action, 1 - noise), *((side, noise / 2) for side in sides)]

    def winds(self, cell):
        row, column = cell
        up = self.rules.get("wind", [0] * self.columns)[column]
        right = self.rules.get("wind_rows", [0] * len(self.lines))[row]
        gusts = self.rules.get("gusts", False)
        ups = [up - 1, up, up + 1] if gusts and up else [up]
        rights = [right - 1, right, right + 1] if gusts and right else [right]
        return [((-u, r), 1 / len(ups) / len(rights)) for u in ups for r in rights]

    def walk(self, cell, happened, wind_down, wind_right):
        down, right = STEPS[happened]
        if happened not in self.at(cell).get("only", [happened]):
            down = right = 0
        if down * wind_down < 0:
            down, wind_down = 0, wind_down + down
        if right * wind_right < 0:
            right, wind_right = 0, wind_right + right
        target = (cell[0] + down, cell[1] + right)
        bumped = not self.is_open(target)
        here = cell if bumped else target
        here = self.blown(here, (1 if wind_down > 0 else -1, 0), abs(wind_down))
        return self.blown(here, (0, 1 if wind_right > 0 else -1), abs(wind_right)), bumped

    def blown(self, cell, step, times):
        for _ in range(times):
            target = (cell[0] + step[0], cell[1] + step[1])
            if not self.is_open(target):
                break
            cell = target
        return cell

    def arrival(self, cell, entered, bumped):
        reward = self.rules.get("step_reward", 0.0) + (self.rules.get("bump_reward", 0.0) if bumped else 0.0)
        if self.rules.get("rewards") == "leaving":
            reward += self.pays(cell)
        elif not self.at(entered).get("exit"):
            reward += self.pays(entered)
        landed = self.starts[0] if self.at(entered).get("back") else entered
        return self.number(landed), reward, self.is_terminal(landed)

    def reached(self):
        reached, to_visit = set(self.starts), list(self.starts)
        while to_visit:
            cell = to_visit.pop()
            for action in self.actions:
                for _, number, _, terminated in self.outcomes(cell, action):
                    landed = divmod(number, self.columns)
                    if not terminated and landed not in reached:
                        reached.add(landed)
                        to_visit.append(landed)
        return reached
