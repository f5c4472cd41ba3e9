/* The properties of what a scene has, and the options of the faces of the box. */
#include "domain.h"

const char *const FaceNames[DIM][2] = {{"xmin", "xmax"}, {"ymin", "ymax"}, {"zmin", "zmax"}};

#define ANY_FACE "box_<face>_" /* no option of a scene has these signs */

PetscErrorCode DomainAddProperty(Domain domain, const Property *property)
{
  PetscFunctionBegin;
  PetscCall(PetscRealloc((size_t)(domain->property_count + 1) * sizeof(*domain->property), &domain->property));
  domain->property[domain->property_count++] = property;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bytes that the data of a property take up among those of others. */
static size_t Room(const Property *property)
{
  return (property->size + sizeof(PetscReal) - 1) / sizeof(PetscReal) * sizeof(PetscReal);
}

const Property *PropertiesWalk(Domain domain, const Properties *own, PetscInt k, void **data)
{
  size_t at = 0;

  for (PetscInt p = 0; p < domain->property_count && own->data; p++) {
    const Property *property = domain->property[p];

    if (property->owner != own->owner) continue;
    *data = own->data + at;
    if (k-- == 0) return property;
    at += Room(property);
  }
  return NULL;
}

void *PropertyOf(Domain domain, const Properties *own, const Property *property)
{
  void           *data = NULL;
  const Property *found;

  for (PetscInt k = 0; (found = PropertiesWalk(domain, own, k, &data)); k++)
    if (found == property) return data;
  return NULL;
}

PetscErrorCode PropertiesMake(Domain domain, Owner owner, Properties *own)
{
  size_t          bytes = 1;
  const Property *property;
  void           *data;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < domain->property_count; p++)
    if (domain->property[p]->owner == owner) bytes += Room(domain->property[p]);
  own->owner = owner;
  PetscCall(PetscFree(own->data));
  PetscCall(PetscCalloc(bytes, (void **)&own->data));
  for (PetscInt k = 0; (property = PropertiesWalk(domain, own, k, &data)); k++)
    if (property->defaults) property->defaults(data);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PropertiesRead(Domain domain, OptionItems PetscOptionsObject, Owner owner, Properties *own)
{
  const char     *prefix = PetscOptionsObject->prefix ? PetscOptionsObject->prefix : "";
  const Property *property;
  void           *data;

  PetscFunctionBegin;
  PetscCall(PropertiesMake(domain, owner, own));
  for (PetscInt k = 0; (property = PropertiesWalk(domain, own, k, &data)); k++) {
    PetscCall(DomainReadOptions(domain, PetscOptionsObject, property->rows, "SceneSetFromOptions", data));
    if (property->check) PetscCall(property->check(domain, prefix, data));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PropertiesNote(Domain domain, const char prefix[], const char why[], Owner owner)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < domain->property_count; p++)
    if (domain->property[p]->owner == owner) PetscCall(OptionsNote(prefix, why, domain->property[p]->rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PropertiesFree(Properties *own)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(own->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool PropertiesSame(Domain domain, const Properties *one, const Properties *other)
{
  const Property *property;
  void           *a, *b;

  if (one->owner != other->owner) return PETSC_FALSE;
  for (PetscInt k = 0; (property = PropertiesWalk(domain, one, k, &a)); k++)
    if (!PropertiesWalk(domain, other, k, &b) || !OptionsSame(property->rows, a, b)) return PETSC_FALSE;
  return PETSC_TRUE;
}

void PropertiesIdentity(Domain domain, const Properties *own, const char prefix[], FILE *text)
{
  const Property *property;
  void           *data;

  for (PetscInt k = 0; (property = PropertiesWalk(domain, own, k, &data)); k++)
    OptionsIdentity(text, prefix, property->rows, data, domain->dim);
}

void PropertiesJson(Domain domain, const Properties *own, Json *json)
{
  const Property *property;
  void           *data;

  for (PetscInt k = 0; (property = PropertiesWalk(domain, own, k, &data)); k++)
    OptionsValues(json, property->rows, data, domain->dim);
}

/* Reads the rows of a face into its data; NULL: its properties. silent: -help has told them. */
static PetscErrorCode ReadFace(Domain domain, const OptionRow rows[], const char function[], const char prefix[],
                               PetscBool silent, void *data)
{
  PetscFunctionBegin;
  PetscOptionsBegin(domain->comm, prefix, "Face of the box, any", "Domain");
  if (silent) PetscOptionsObject->alreadyprinted = PETSC_TRUE;
  if (rows)
    PetscCall(DomainReadOptions(domain, PetscOptionsObject, rows, function, data));
  else
    PetscCall(PropertiesRead(domain, PetscOptionsObject, OWNER_FACE, (Properties *)data));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DomainReadFaces(Domain domain, const OptionRow rows[], const char function[], size_t stride, void *data)
{
  PetscFunctionBegin;
  if (OptionsAll()) { /* -help and its like tell the options once, those of any face */
    char *any;

    PetscCall(PetscCalloc(stride, (void **)&any));
    PetscCall(ReadFace(domain, rows, function, ANY_FACE, PETSC_FALSE, any));
    if (!rows) PetscCall(PropertiesFree((Properties *)any));
    PetscCall(PetscFree(any));
  }
  for (PetscInt f = 0; f < 2 * domain->dim; f++) {
    char prefix[OPTION_WORD_LENGTH];

    if (DomainIsRadial(domain, f / 2) && f % 2 == 0) continue; /* the axis */
    PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "box_%s_", FaceNames[f / 2][f % 2]));
    PetscCall(ReadFace(domain, rows, function, prefix, OptionsAll(), (char *)data + (size_t)f * stride));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
