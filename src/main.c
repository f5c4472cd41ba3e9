#include "isph.h"

int main(int argc, char *argv[])
{
  return IsphMain(argc, argv);
}
