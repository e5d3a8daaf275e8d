/* Stands in for the bcryptprimitives.dll that Wine 8 lacks, so that programs made by Rust run under it. Windows has its own:
   this one is for tests only. */
#include <windows.h>

BOOLEAN NTAPI SystemFunction036(PVOID buffer, ULONG length); /* RtlGenRandom */

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE data, SIZE_T length)
{
    return SystemFunction036(data, (ULONG)length);
}
