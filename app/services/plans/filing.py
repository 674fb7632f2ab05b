"""Mission files taken in as plans: judged at the desk, kept, done at once."""

from __future__ import annotations

from pathlib import Path

import structlog

from app.services.desk import Desk
from app.services.plans.mission_files import filed_beside
from app.services.plans.mission_scene import FileChoice
from app.services.records import PlanRecord
from app.services.scenarios.kept import ScenarioService
from app.services.store.plans import PlanStore

log = structlog.get_logger(__name__)


class Filing:
    """Where mission files come in.

    Parameters
    ----------
    terrain_folder
        Where uploaded rasters are.
    """

    def __init__(
        self, store: PlanStore, scenarios: ScenarioService, desk: Desk, terrain_folder: Path
    ) -> None:
        self._store = store
        self._scenarios = scenarios
        self._desk = desk
        self._terrain_folder = terrain_folder

    async def take(self, content: bytes, choice: FileChoice, scenario_id: str | None) -> PlanRecord:
        """Read and judge a mission file, and keep it as a plan that is done.

        Parameters
        ----------
        scenario_id
            The kept scenario by whose zones, area, ground and aircraft it is judged.

        Raises
        ------
        RefusedError
            It cannot be read, or does not go with the scenario.
        NotFoundError
            There is no such scenario.
        """
        scenario_text = None if scenario_id is None else await self._scenarios.text(scenario_id)
        plan = await self._desk.run(
            "file", filed_beside, content, choice, scenario_text, str(self._terrain_folder)
        )
        record = await self._store.add_done(
            plan.name,
            plan.scenario,
            plan.plan,
            plan.digest,
            plan.warnings,
            scenario_id,
            plan.scenario_hash,
            plan.summary,
        )
        log.info("mission file taken in", plan_id=record.id, name=plan.name)
        return record
