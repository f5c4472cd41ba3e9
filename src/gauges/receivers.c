/* The walls of the box, then the solids: what receives forces and is wetted. */
#include "gauges_impl.h"

PetscInt GaugeWallFace(Domain domain, PetscInt index, PetscInt *direction, PetscInt *side)
{
  PetscInt count = 0;

  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt s = 0; s < 2; s++) {
      if (domain->face[d][s] != FACE_WALL) continue;
      if (count == index) {
        *direction = d;
        *side      = s;
      }
      count++;
    }
  return count;
}

PetscInt GaugeReceivers(Gauges gauges)
{
  return GaugeWallFace(gauges->cloud->domain, -1, NULL, NULL) + SceneSolidCount(gauges->cloud->scene);
}

const char *GaugeReceiverName(Gauges gauges, PetscInt receiver)
{
  PetscInt       d = 0, side = 0;
  const PetscInt faces = GaugeWallFace(gauges->cloud->domain, receiver, &d, &side);

  return receiver < faces ? FaceNames[d][side] : BodyName(SceneSolid(gauges->cloud->scene, receiver - faces));
}
