/* A property that no line of the program knows: whatever compares, tells or writes a scene sees it, of each kind of
   owner. */
#include "../../src/scene/body.h"
#include "../../src/sim/sim_impl.h"
#include "check.h"
#include "setup.h"
#include <stdlib.h>
#include <string.h>

#define DEFAULT 3.5

static const OptionRow sweet[]  = {{"-sweetness", "Of any owner", "kg", "[0, inf)", ROW_REAL, 0}, {.name = NULL}};
static const OptionRow bitter[] = {{"-bitterness", "Of any owner; a restart may change it", "kg", "[0, inf)", ROW_REAL,
                                    0, .changes = PETSC_TRUE},
                                   {.name = NULL}};

static void Defaults(void *data)
{
  *(PetscReal *)data = DEFAULT;
}

static PetscErrorCode Check(Domain domain, const char prefix[], void *data)
{
  PetscFunctionBegin;
  PetscCheckUser(*(PetscReal *)data < 9, domain->comm, "-%ssweetness must be less than 9", prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define OF(owner)                                                                                                      \
  {owner, sizeof(PetscReal), sweet, Defaults, Check},                                                                  \
  {                                                                                                                    \
    owner, sizeof(PetscReal), bitter, NULL, NULL                                                                       \
  }
static const Property properties[] = {OF(OWNER_SCENE), OF(OWNER_FACE), OF(OWNER_BODY),
                                      OF(OWNER_SOLID), OF(OWNER_HOLE), {.rows = NULL}};

/* Two equal halves: a body with a hole and a solid on either side. */
#define TWINS                                                                                                          \
  "-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 8,4 -box_x wall -box_ymin wall -bodies left,right -solids p,q " \
  "-left_lower 0.5,0 -left_upper 2.5,2 -right_lower 5.5,0 -right_upper 7.5,2 -p_lower 3,0 -p_upper 3.5,1 -q_lower "    \
  "4.5,0 -q_upper 5,1 -left_holes a -right_holes b -a_shape sphere -a_center 1.5,1 -a_radius 0.5 -b_shape sphere "     \
  "-b_center 6.5,1 -b_radius 0.5 "

/* What is said about a scene; to be freed with free(). */
typedef struct {
  PetscBool mirror, alike;
  char     *identity, *json, *view;
} Said;

static PetscErrorCode Say(const char more[], Said *said)
{
  char          options[2048];
  Setup         s;
  struct _p_Sim sim = {.comm = PETSC_COMM_WORLD};
  SceneModel    model;
  size_t        length;
  Json          json = {.file = open_memstream(&said->json, &length)};
  FILE         *text = open_memstream(&said->identity, &length), *view = tmpfile();
  PetscViewer   viewer;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), TWINS "%s", more));
  PetscCall(SetupOpenWith(PETSC_COMM_WORLD, options, properties, &s));
  sim.domain  = s.domain;
  sim.scene   = s.scene;
  sim.tension = s.tension;
  ModelFind(&sim, &model);
  said->mirror = model.mirror[0].holds;
  said->alike  = BodiesAlike(SceneBody(s.scene, 0), SceneBody(s.scene, 1));
  PetscCall(SceneIdentity(s.scene, text));
  JsonObject(&json, NULL);
  DomainJson(s.domain, &json);
  SceneJson(s.scene, 0, 1, &json);
  JsonEnd(&json);
  PetscCall(PetscViewerASCIIOpenWithFILE(PETSC_COMM_WORLD, view, &viewer));
  PetscCall(SceneView(s.scene, viewer));
  PetscCall(PetscViewerDestroy(&viewer));
  (void)fclose(json.file);
  (void)fclose(text);
  PetscCall(PetscCalloc1(8192, &said->view));
  rewind(view);
  CHECK(fread(said->view, 1, 8191, view) > 0, "view");
  (void)fclose(view);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Forget(Said *said)
{
  PetscFunctionBegin;
  free(said->identity);
  free(said->json);
  PetscCall(PetscFree(said->view));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt Times(const char text[], const char word[])
{
  PetscInt n = 0;

  for (const char *at = strstr(text, word); at; at = strstr(at + 1, word)) n++;
  return n;
}

int main(int argc, char **argv)
{
  static const char *const owners[] = {"right", "q", "b", "box_xmax"};
  Said                     plain, other;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(Say("", &plain));
  CHECK(plain.mirror && plain.alike, "equal_halves");
  CHECK(Times(plain.json, "\"sweetness\": 3.5") == 11,
        "all_are_in_the_json"); /* the scene, 2 bodies, 2 holes, 2 solids, 4 faces */
  CHECK(Times(plain.identity, "sweetness = 3.5") == 11 && !Times(plain.identity, "bitterness"), "all_are_identity");
  CHECK(!Times(plain.view, "sweetness") && !Times(plain.view, "bitterness"), "defaults_are_not_viewed");
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(owners); k++) {
    char option[128], name[128];

    for (int taste = 0; taste < 2; taste++) {
      const char *word = taste ? "bitterness" : "sweetness";

      PetscCall(PetscSNPrintf(option, sizeof(option), "-%s_%s 4.25", owners[k], word));
      PetscCall(Say(option, &other));
      PetscCall(PetscSNPrintf(name, sizeof(name), "%s_of_%s_is_no_mirror", word, owners[k]));
      CHECK(!other.mirror, name);
      PetscCall(PetscSNPrintf(name, sizeof(name), "%s_of_%s_is_told", word, owners[k]));
      CHECK(Times(other.json, "4.25") == 1, name);
      PetscCall(PetscSNPrintf(name, sizeof(name), "%s_of_%s_at_a_restart", word, owners[k]));
      CHECK((PetscBool)!strcmp(other.identity, plain.identity) == (PetscBool)(taste == 1), name);
      CHECK(other.alike == (PetscBool)(k > 0), "bodies_of_one_liquid");
      CHECK(Times(other.view, word) == (k == 0) && Times(other.view, " 4.25 kg") == (k == 0), "bodies_are_viewed");
      PetscCall(Forget(&other));
    }
  }
  PetscCall(Say("-sweetness 4.25", &other));
  CHECK(other.mirror && Times(other.identity, "-sweetness = 4.25") == 1 &&
          Times(other.json, "\"sweetness\": 4.25") == 1,
        "of_the_scene");
  PetscCall(Forget(&other));
  PetscCall(Forget(&plain));
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
