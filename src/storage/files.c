/* Folders and files. */
#include "storage.h"
#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

int FolderCreate(const char folder[])
{
  char        path[PETSC_MAX_PATH_LEN];
  struct stat info;

  if (snprintf(path, sizeof(path), "%s", folder) >= (int)sizeof(path)) return ENAMETOOLONG;
  for (char *end = path + 1;; end++) {
    const char kept = *end;

    if (kept != '/' && kept) continue;
    *end = '\0';
    if (mkdir(path, S_IRWXU | S_IRWXG | S_IRWXO) && errno != EEXIST) return errno;
    if (!kept) break;
    *end = kept;
  }
  if (stat(path, &info)) return errno;
  return S_ISDIR(info.st_mode) ? 0 : ENOTDIR;
}

int FileSync(const char path[])
{
  const int descriptor = open(path, O_RDONLY);
  int       error;

  if (descriptor < 0) return errno;
  /* EINVAL, EROFS: the file system cannot sync */
  error = fsync(descriptor) && errno != EINVAL && errno != EROFS ? errno : 0;
  close(descriptor);
  return error;
}
